//! `record` of topics of a Foxglove WebSocket server: they are subscribed to and listened to first.

#[cfg(feature = "foxglove")]
pub(super) use listening::open;

/// A program without the protocol.
#[cfg(not(feature = "foxglove"))]
pub(super) fn open(
    _: &mut crate::device::source::Link,
    name: &str,
    _: &[String],
    _: &super::described::SourceArgs,
    _: &crate::interrupt::Interrupt,
) -> anyhow::Result<super::opened::Opened> {
    let problem = format!("{name}: this program was built without `foxglove`, which subscribes to topics");
    Err(crate::output::WrongArguments(problem).into())
}

#[cfg(feature = "foxglove")]
mod listening {
    use anyhow::bail;
    use socam_sources::foxglove::{Connection, Message, Said, Survey, Topics};
    use socam_sources::{Device, Timeline};

    use crate::commands::record::described::{SourceArgs, described};
    use crate::commands::record::opened::Opened;
    use crate::device::source::{Link, Listened};
    use crate::interrupt::Interrupt;
    use crate::output;

    /// Time for which topics are listened to, once one has a message, ns.
    const LISTEN_NS: i64 = 1_500_000_000;
    /// Longest time until all topics have messages, ns.
    const SILENT_NS: i64 = 8_000_000_000;
    /// Longest time until the server has said what it has, ns.
    const GREETING_NS: i64 = 5_000_000_000;
    /// Time after which a server is taken to have said all that it has, ns.
    const ADVERTISED_NS: i64 = 1_000_000_000;

    /// Subscribes to topics and finds out what they hold.
    pub(in crate::commands::record) fn open(
        link: &mut Link,
        name: &str,
        topics: &[String],
        args: &SourceArgs,
        interrupt: &Interrupt,
    ) -> anyhow::Result<Opened> {
        let survey = listen(link, name, topics, interrupt)?;
        let found = |take_guesses| survey.found(take_guesses);
        let description = described(args, name, found, |description| Ok(survey.check(description)?))?;
        output::say(format_args!("{name}: each message of `{}` gives a row", survey.rows()));
        let device = Topics::new(survey, description.read);
        let timeline = Timeline::new(device.numbering(), None);
        let heard = Listened(Vec::new());
        Ok(Opened { device: Box::new(device), timeline, heard, description: Some(description.text) })
    }

    fn listen(
        link: &mut Link,
        name: &str,
        topics: &[String],
        interrupt: &Interrupt,
    ) -> anyhow::Result<Survey> {
        let told = |error: socam_sources::SourceError| anyhow::anyhow!("{name}: {error}");
        let address = link.address().unwrap_or_default().to_owned();
        let mut connection = Connection::new(&address, topics).map_err(told)?;
        let mut messages: Vec<Message> = Vec::new();
        let (mut subscribed_ns, mut outgoing, mut damage) = (None, Vec::new(), None);
        loop {
            if interrupt.count() > 0 {
                bail!("stopped before the first sample");
            }
            connection.send(&mut outgoing).map_err(told)?;
            if !outgoing.is_empty() {
                link.send(&outgoing)?;
                outgoing.clear();
            }
            let now_ns = link.now_ns();
            match subscribed_ns {
                None if connection.is_subscribed().map_err(told)? => subscribed_ns = Some(now_ns),
                None if now_ns > GREETING_NS => bail!("{name}: {}", connection.missing()),
                None if now_ns > ADVERTISED_NS && connection.topics().next().is_none() => {
                    connection.choose().map_err(told)?;
                }
                Some(since_ns) if now_ns - since_ns > SILENT_NS => break,
                Some(_) => {
                    let is_heard = (0..connection.topics().count())
                        .all(|topic| messages.iter().any(|message| message.topic == topic));
                    let first = messages.first();
                    if is_heard && first.is_some_and(|first| now_ns - first.arrival_ns > LISTEN_NS) {
                        break;
                    }
                }
                None => {}
            }
            match link.read() {
                Ok(Some(arrived)) => connection.receive(arrived.chunk(), |_, said| match said {
                    Said::Message(message) => messages.push(message),
                    Said::Note(text, true) => output::warn(format_args!("{name}: {text}")),
                    Said::Damaged(problem) => damage = Some(problem),
                    Said::Note(_, false) => {}
                }),
                Ok(None) => {}
                Err(error) => bail!("the link to {name} broke before the first sample: {error}"),
            }
        }
        match damage.filter(|_| messages.is_empty()) {
            Some(problem) => bail!("{name}: {problem}"),
            None => Survey::new(connection, messages).map_err(told),
        }
    }
}
